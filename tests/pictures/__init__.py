"""Tests of pictures and HTML for notebooks."""
