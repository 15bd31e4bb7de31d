"""Independent numerics: never imports the algebra it is there to check."""
