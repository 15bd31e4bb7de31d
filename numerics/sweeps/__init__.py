"""Many runs on many cores, resumed where they stopped."""
