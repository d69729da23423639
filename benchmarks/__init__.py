"""What things cost, and what the same would cost by other means."""
