"""What a recording's file holds: tables of text and workbooks, and what programs save in forms of their own."""
