! A library without the entry point.
subroutine umat()
end subroutine
