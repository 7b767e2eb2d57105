"""The numbers of a report: data, statistical models and summaries."""
