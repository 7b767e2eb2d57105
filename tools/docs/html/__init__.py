"""What is done to the HTML of the site's pages."""
