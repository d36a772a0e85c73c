! Linear elasticity (E = props(1), nu = 0) that fails as asked from the time props(3) on; props(2) says how:
!   1 a stress that is not a number   2 abort          3 STOP with words   4 exit with code 0   5 _exit with code 0
!   6 a null pointer                  7 never returns  8 more stack than there is
!   9 state 5, however many there are     10 stress 5 and 6     11 the word before stressNew
!  12 changes coordMp and props           13 answers by a counter of its own     14 stress 33 as of a solid
!  15 xplb_abqerr with -3                 16 xplb_exit
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

  integer, save :: counter = 0
  integer, pointer :: nowhere
  integer :: k
  interface
    subroutine leave_at_once(code) bind(c, name='_exit')
      use, intrinsic :: iso_c_binding
      integer(c_int), value :: code
    end subroutine
  end interface

  stressNew = stressOld + props(1)*strainInc
  stressNew(:, 3) = 0
  if (totalTime < props(3)) return
  select case (nint(props(2)))
  case (1)
    stressNew(1, 1) = ieee_value(1d0, ieee_quiet_nan)
  case (2)
    call abort()
  case (3)
    write (*, *) 'no convergence of the return mapping'
    stop
  case (4)
    write (*, *) 'no convergence of the return mapping'
    call exit(0)
  case (5)
    write (*, *) 'no convergence of the return mapping'
    call leave_at_once(0)
  case (6)
    write (*, *) 'no convergence of the return mapping'
    nowhere => null()
    nowhere = 1
  case (7)
    do
      counter = counter + 1
      if (counter < 0) counter = 0
    end do
  case (8)
    call dig(1d0)
  case (9)
    stateNew(:nblock, 5) = stateOld(:nblock, 5) + strainInc(:, 1)
  case (10)
    do k = 5, 6
      call add(stressNew(1, 1), nblock*(k - 1))
    end do
  case (11)
    call add(stressNew(1, 1), -1)
  case (12)
    coordMp = 0
    props(1) = 2*props(1)
  case (13)
    counter = counter + 1
    stressNew(:, 1) = stressNew(:, 1)*(1 + 1d-3*counter)
  case (14)
    stressNew(:, 3) = 0.4d0*stressNew(:, 1)
  case (15)
    call xplb_abqerr(-3, 'no convergence in %I iterations, error %R, in %S', [12], [0.5d0], 'FLOW    ')
  case (16)
    write (*, *) 'no convergence of the return mapping'
    call xplb_exit
  end select

contains

  recursive subroutine dig(x)
    real(8), intent(in) :: x
    real(8) :: room(100000)
    room = x
    call dig(sum(room) + x)
    room(1) = room(2) + x
    if (room(1) < 0) write (*, *) room
  end subroutine

  subroutine add(array, offset)
    real(8) :: array(0:*)
    integer, intent(in) :: offset
    integer :: i
    do i = offset, offset + merge(nblock - 1, 0, offset > 0)
      call change(array, i)
    end do
  end subroutine

  subroutine change(array, i)
    integer, intent(in) :: i
    real(8) :: array(0:i)
    array(i) = array(i) + 1d-3
  end subroutine
end subroutine
