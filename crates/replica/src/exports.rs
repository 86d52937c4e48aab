//! Functions that JavaScript calls: bytes in, a text out.
#![allow(unsafe_code, reason = "an exported name is all that is unsafe here")]

use std::sync::{Mutex, PoisonError};

use palpate::Arch;

use crate::{Extent, tables};

/// Bytes of the config, then of the answer.
static BYTES: Mutex<Vec<u8>> = Mutex::new(Vec::new());

fn with_bytes<T>(change: impl FnOnce(&mut Vec<u8>) -> T) -> T {
    change(&mut BYTES.lock().unwrap_or_else(PoisonError::into_inner))
}

/// Appends a byte of the config.
#[unsafe(no_mangle)]
extern "C" fn push(byte: u32) {
    with_bytes(|bytes| bytes.push(byte as u8));
}

/// Runs the config that was pushed and gives the number of bytes of the answer: its tables, or "error: " and a message.
#[unsafe(no_mangle)]
extern "C" fn run(cells: u32, trials: u32) -> u32 {
    let config = with_bytes(std::mem::take);
    let extent = Extent {
        cells: cells as usize,
        trials: trials.into(),
    };
    let answer = match String::from_utf8(config) {
        Ok(config) => tables("config", &config, extent, Arch::new()),
        Err(error) => Err(error.to_string()),
    };
    let answer = answer.unwrap_or_else(|message| format!("error: {message}\n"));
    with_bytes(|bytes| {
        *bytes = answer.into_bytes();
        bytes.len() as u32
    })
}

/// Takes a byte of the answer from its end; 0 where there is none left.
#[unsafe(no_mangle)]
extern "C" fn pull() -> u32 {
    with_bytes(|bytes| bytes.pop().unwrap_or(0).into())
}
