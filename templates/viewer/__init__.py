"""Templates of pages with pictures of mechanisms, and the script that they share."""
