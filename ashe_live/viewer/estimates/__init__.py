"""The light as it is asked for, sharpened, followed and eased, and where the model stands in it."""
