"""The documentation: pages in `pages`, their code blocks run, the reference generated, a web site built."""
