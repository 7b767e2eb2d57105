"""The report's page: sections, tables and plots."""
