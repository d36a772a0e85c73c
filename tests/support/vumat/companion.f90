! A law whose table another routine would fill, which interply never calls.
subroutine vumat(nblock, ndir, nshr, nstatev, nfieldv, nprops, lanneal, stepTime, totalTime, dt, cmname, coordMp, &
                 charLength, props, density, strainInc, relSpinInc, tempOld, stretchOld, defgradOld, fieldOld, &
                 stressOld)
  integer :: nblock, ndir, nshr, nstatev, nfieldv, nprops, lanneal
  real(8) :: stressOld(nblock, 4)
end subroutine
subroutine vexternaldb()
end subroutine
