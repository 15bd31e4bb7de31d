"""The rope and its drives, stated independently of the algebra."""
