"""The interactive page: payload.py turns tables into the data that it embeds, page.py puts it together, the rest is
what runs in the browser."""
