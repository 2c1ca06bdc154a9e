//! The functions of strings and arrays that ufbx calls where there is no C library, under the names
//! that it gives them (`UFBX_NO_LIBC` in ufbx.c).

#![expect(unsafe_code, reason = "C calls these functions by name and with raw pointers")]

use std::ffi::c_int;

// SAFETY, for all functions: ufbx passes what the functions of the same name
// in C ask for, pointers to that many bytes or to a text with a NUL at its end.

#[unsafe(no_mangle)]
unsafe extern "C" fn ufbx_strlen(text: *const u8) -> usize {
    let mut length = 0;
    while unsafe { *text.add(length) } != 0 {
        length += 1;
    }
    length
}

#[unsafe(no_mangle)]
unsafe extern "C" fn ufbx_memcpy(to: *mut u8, from: *const u8, count: usize) -> *mut u8 {
    unsafe { std::ptr::copy_nonoverlapping(from, to, count) };
    to
}

#[unsafe(no_mangle)]
unsafe extern "C" fn ufbx_memmove(to: *mut u8, from: *const u8, count: usize) -> *mut u8 {
    unsafe { std::ptr::copy(from, to, count) };
    to
}

#[unsafe(no_mangle)]
unsafe extern "C" fn ufbx_memset(to: *mut u8, byte: c_int, count: usize) -> *mut u8 {
    unsafe { std::ptr::write_bytes(to, byte as u8, count) };
    to
}

#[unsafe(no_mangle)]
unsafe extern "C" fn ufbx_memchr(bytes: *const u8, byte: c_int, count: usize) -> *const u8 {
    for place in 0..count {
        let here = unsafe { bytes.add(place) };
        if unsafe { *here } == byte as u8 {
            return here;
        }
    }
    std::ptr::null()
}

#[unsafe(no_mangle)]
unsafe extern "C" fn ufbx_memcmp(x: *const u8, y: *const u8, count: usize) -> c_int {
    for place in 0..count {
        let (x, y) = unsafe { (*x.add(place), *y.add(place)) };
        if x != y {
            return c_int::from(x) - c_int::from(y);
        }
    }
    0
}

#[unsafe(no_mangle)]
unsafe extern "C" fn ufbx_strcmp(x: *const u8, y: *const u8) -> c_int {
    unsafe { ufbx_strncmp(x, y, usize::MAX) }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn ufbx_strncmp(x: *const u8, y: *const u8, count: usize) -> c_int {
    for place in 0..count {
        let (x, y) = unsafe { (*x.add(place), *y.add(place)) };
        if x != y || x == 0 {
            return c_int::from(x) - c_int::from(y);
        }
    }
    0
}
