"""Programs that call a contestant's code, give results and take the time; compiled when they are needed."""
