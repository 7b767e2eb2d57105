"""Changes to the HTML of the site's pages."""
