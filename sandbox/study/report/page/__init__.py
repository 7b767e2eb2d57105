"""The page of the report: sections, tables and plots."""
