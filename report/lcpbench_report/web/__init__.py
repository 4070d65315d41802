"""The page: page.py puts it together, page.js shows its charts."""
