"""Results in words, as text, LaTeX and JSON; and the run that is watched for them."""
