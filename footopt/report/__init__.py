"""What a reader looks at: figures of feet, walks and searches. Only this package imports matplotlib."""
