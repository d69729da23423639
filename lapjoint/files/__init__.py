"""Reading and writing files safely: sizes and names are checked, and no file is ever left half written."""
