//! The API as a client meets it: the real routes on a real socket.

mod account;
mod crowd;
mod house;
mod omlox;
mod people;
mod tls;
mod walk;
mod watching;
