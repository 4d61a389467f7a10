"""The swing that would tell what this one leaves open."""
