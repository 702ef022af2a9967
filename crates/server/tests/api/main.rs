//! The API as a client meets it: the real routes on a real socket.

mod account;
mod feed;
mod house;
mod keeping;
mod omlox;
mod pages;
mod past;
mod people;
mod tls;
mod walk;
mod watching;
