"""What is recorded: clips of pictures, and clips of what is drawn over them."""
