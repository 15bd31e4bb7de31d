"""Where the wave-less state is lost, as intervals."""
