"""Files that stand beside the generated C, each made for one kind of user."""
