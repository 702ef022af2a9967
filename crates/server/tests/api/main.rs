//! The API as a client meets it: the real routes on a real socket.

mod account;
mod house;
mod people;
mod walk;
mod watching;
