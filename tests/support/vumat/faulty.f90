! Linear elasticity (E = props(1), nu = 0) that fails as asked from the time props(3) on: props(2) = 1 a stress that is
! not a number, 2 the end of the process.
subroutine vumat(nblock, ndir, nshr, nstatev, nfieldv, nprops, lanneal, stepTime, totalTime, dt, cmname, coordMp, &
                 charLength, props, density, strainInc, relSpinInc, tempOld, stretchOld, defgradOld, fieldOld, &
                 stressOld, stateOld, enerInternOld, enerInelasOld, tempNew, stretchNew, defgradNew, fieldNew, &
                 stressNew, stateNew, enerInternNew, enerInelasNew)
  use, intrinsic :: ieee_arithmetic
  implicit none
  integer :: nblock, ndir, nshr, nstatev, nfieldv, nprops, lanneal
  real(8) :: stepTime, totalTime, dt
  character(len=80) :: cmname
  real(8) :: coordMp(nblock, 3), charLength(nblock), props(nprops), density(nblock)
  real(8) :: strainInc(nblock, ndir + nshr), relSpinInc(nblock, nshr), tempOld(nblock)
  real(8) :: stretchOld(nblock, ndir + nshr), defgradOld(nblock, ndir + 2*nshr), fieldOld(nblock, *)
  real(8) :: stressOld(nblock, ndir + nshr), stateOld(nblock, *), enerInternOld(nblock), enerInelasOld(nblock)
  real(8) :: tempNew(nblock), stretchNew(nblock, ndir + nshr), defgradNew(nblock, ndir + 2*nshr), fieldNew(nblock, *)
  real(8) :: stressNew(nblock, ndir + nshr), stateNew(nblock, *), enerInternNew(nblock), enerInelasNew(nblock)

  stressNew = stressOld + props(1)*strainInc
  stressNew(:, 3) = 0
  if (totalTime < props(3)) return
  if (props(2) == 1) stressNew(1, 1) = ieee_value(1d0, ieee_quiet_nan)
  if (props(2) == 2) call abort()
end subroutine
