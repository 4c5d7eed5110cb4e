//! Whole stacks in virtual time: the harness, the paper as tests, and the rules of the repository
