"""Cars, curves and situations that several tests build on."""
