/// Utility routines of Abaqus/Explicit that a user's own law may call: our programs export them to its library.
///
///   xplb_abqerr(lop, text, intv, realv, charv)  prints the text, %I, %R and %S filled in from the arrays; -3 ends
///   xplb_exit()                                 ends the run, as STOP does
///   vgetoutdir(folder, length)                  the folder that the program was started in
///   vgetnumcpus(n), vgetrank(n)                 1 and 0: one process per layer
///   get_thread_id(), getnumthreads()            0 and 1: one thread per layer
#pragma once

namespace interply::solve {

/// "xplb_abqerr, xplb_exit, ...", for who calls another one.
const char* list_vumat_utilities();

}  // namespace interply::solve
