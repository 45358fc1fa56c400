"""Independent reference solutions for the multibody tests: numpy, scipy and mpmath only, never visviva
itself."""
