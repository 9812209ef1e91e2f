"""Views compressed by meshoptimizer: KHR_meshopt_compression, and EXT_meshopt_compression, from which it came."""
