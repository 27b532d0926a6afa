"""What header, example and README say about a model, as plain data for the templates."""
