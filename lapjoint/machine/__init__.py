"""What the machine lends to a computation: processes, memory, threads of linear algebra."""
