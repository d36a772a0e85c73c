! A law that calls a routine that nobody has.
subroutine vumat(nblock, ndir, nshr, nstatev, nfieldv, nprops, lanneal, stepTime, totalTime, dt, cmname, coordMp, &
                 charLength, props, density, strainInc, relSpinInc, tempOld, stretchOld, defgradOld, fieldOld, &
                 stressOld)
  integer :: nblock, ndir, nshr, nstatev, nfieldv, nprops, lanneal
  real(8) :: stressOld(nblock, 4)
  call vgetvrm('S', stressOld)
end subroutine
