//! Maps and planning domains: the data, and the code that reads and checks them
