"""The command line: what is asked, and in which order things are done."""
