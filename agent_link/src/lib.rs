//! Everything that waits: the zenoh session and keys, the wire types and the one driver loop
