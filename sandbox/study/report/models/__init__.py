"""Numbers of a report: data, statistical models and summaries."""
