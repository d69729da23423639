"""What answers are held against: numbers of others with their addresses, and witnesses without code of the project."""
