"""What all commands share that play a source, in a window or without one."""
