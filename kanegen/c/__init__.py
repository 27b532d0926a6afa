"""From programs to C: expressions, function bodies, declarations, and the files around them."""
