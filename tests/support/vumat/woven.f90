! The woven ply of solver_fabric/THEORY.md as a VUMAT, written from its equations: variant `full`; `uncoupled` with
! c = 0, p_min = 1 and s_T = s_C = 0. The two must agree to round-off.
!
! props: a_warp, a_weft, b.., c.., p_min.., d.., s1, s2, s3, s_T.., s_C.., strain_cap..
subroutine vumat(nblock, ndir, nshr, nstatev, nfieldv, nprops, lanneal, stepTime, totalTime, dt, cmname, coordMp, &
                 charLength, props, density, strainInc, relSpinInc, tempOld, stretchOld, defgradOld, fieldOld, &
                 stressOld, stateOld, enerInternOld, enerInelasOld, tempNew, stretchNew, defgradNew, fieldNew, &
                 stressNew, stateNew, enerInternNew, enerInelasNew)
  implicit none
  integer, intent(in) :: nblock, ndir, nshr, nstatev, nfieldv, nprops, lanneal
  real(8), intent(in) :: stepTime, totalTime, dt
  character(len=80), intent(in) :: cmname
  real(8), intent(in) :: coordMp(nblock, 3), charLength(nblock), props(nprops), density(nblock)
  real(8), intent(inout) :: strainInc(nblock, ndir + nshr)
  real(8), intent(in) :: relSpinInc(nblock, nshr), tempOld(nblock), stretchOld(nblock, ndir + nshr)
  real(8), intent(in) :: defgradOld(nblock, ndir + 2*nshr), fieldOld(nblock, nfieldv)
  real(8), intent(in) :: stressOld(nblock, ndir + nshr), stateOld(nblock, nstatev)
  real(8), intent(in) :: enerInternOld(nblock), enerInelasOld(nblock), tempNew(nblock)
  real(8), intent(in) :: stretchNew(nblock, ndir + nshr), defgradNew(nblock, ndir + 2*nshr)
  real(8), intent(in) :: fieldNew(nblock, nfieldv)
  real(8), intent(inout) :: stressNew(nblock, ndir + nshr), stateNew(nblock, nstatev)
  real(8), intent(inout) :: enerInternNew(nblock), enerInelasNew(nblock)

  real(8) :: a(2), b(2), c(2), p_min(2), d(2), s(3), s_t(2), s_c(2), cap(2)
  real(8) :: f(2, 2), l(2), jacobian, gamma, sine, cosine, g, w_s, dw_s, tau
  real(8) :: n(2), dn(2), k(2), dk(2), t(2), dt_(2), r(2), dr(2), w_l(2), shear, cube
  real(8) :: s11, s22, s12, tangent
  integer :: i, m, o

  a = props(1:2); b = props(3:4); c = props(5:6); p_min = props(7:8); d = props(9:10); s = props(11:13)
  s_t = props(14:15); s_c = props(16:17); cap = props(18:19)

  do i = 1, nblock
    f(1, 1) = defgradNew(i, 1)
    f(2, 2) = defgradNew(i, 2)
    f(1, 2) = defgradNew(i, 4)
    f(2, 1) = defgradNew(i, 5)
    jacobian = f(1, 1)*f(2, 2) - f(1, 2)*f(2, 1)
    l = sqrt(f(1, :)**2 + f(2, :)**2)
    sine = dot_product(f(:, 1), f(:, 2))/(l(1)*l(2))
    cosine = jacobian/(l(1)*l(2))
    gamma = atan2(sine, cosine)
    g = abs(gamma)

    do m = 1, 2
      o = 3 - m
      call tension(l(m), a(m), b(m), d(m), n(m), dn(m))
      k(m) = 1; dk(m) = 0
      if (l(m) > 1) call biaxial(l(o) - 1, c(m), p_min(m), cap(m), k(m), dk(m))  ! a function of the other stretch
      t(m) = 0; dt_(m) = 0; r(m) = 1; dr(m) = 0
      if (l(m) > 1) then
        t(m) = s_t(m)*(l(m)**2 - 1)**2
        dt_(m) = 4*s_t(m)*l(m)*(l(m)**2 - 1)
      else
        r(m) = exp(s_c(m)*(l(m)**2 - 1)**3)
        dr(m) = r(m)*6*s_c(m)*l(m)*(l(m)**2 - 1)**2
      end if
    end do

    w_s = s(1)*g**2/2 + s(2)*g**3/3 + s(3)*g**4/4
    dw_s = s(1)*g + s(2)*g**2 + s(3)*g**3
    cube = g**3/3
    shear = w_s + cube*(t(1) + t(2))
    tau = sign(1d0, gamma)*(dw_s + g**2*(t(1) + t(2)))*r(1)*r(2)
    do m = 1, 2
      o = 3 - m
      w_l(m) = dn(m)*k(m) + n(o)*dk(o) + cube*dt_(m)*r(1)*r(2) + shear*dr(m)*r(o)
    end do

    tangent = tau*sine/cosine
    s11 = w_l(1)/l(1) - tangent/l(1)**2
    s22 = w_l(2)/l(2) - tangent/l(2)**2
    s12 = tau/(cosine*l(1)*l(2))
    ! Cauchy = F S F' / J; the thickness stays
    stressNew(i, 1) = (s11*f(1, 1)**2 + 2*s12*f(1, 1)*f(1, 2) + s22*f(1, 2)**2)/jacobian
    stressNew(i, 2) = (s11*f(2, 1)**2 + 2*s12*f(2, 1)*f(2, 2) + s22*f(2, 2)**2)/jacobian
    stressNew(i, 3) = 0
    stressNew(i, 4) = (s11*f(1, 1)*f(2, 1) + s12*(f(1, 1)*f(2, 2) + f(1, 2)*f(2, 1)) + s22*f(1, 2)*f(2, 2))/jacobian
    if (nstatev > 0) stateNew(i, 1) = gamma
  end do

contains

  ! N of one fibre and its derivative.
  pure subroutine tension(stretch, a, b, d, n, dn)
    real(8), intent(in) :: stretch, a, b, d
    real(8), intent(out) :: n, dn
    real(8) :: e
    e = stretch - 1
    if (stretch > 1) then
      n = a*e**3 + b*e**2
      dn = 3*a*e**2 + 2*b*e
    else
      n = d*e**2
      dn = 2*d*e
    end if
  end subroutine

  ! k_TC and its derivative by the transverse strain e, straight on beyond the cap.
  pure subroutine biaxial(e, c, p_min, cap, k, dk)
    real(8), intent(in) :: e, c, p_min, cap
    real(8), intent(out) :: k, dk
    real(8) :: within
    within = min(e, cap)
    dk = c*(1 - p_min)*exp(c*within)
    k = p_min + (1 - p_min)*exp(c*within) + dk*(e - within)
  end subroutine
end subroutine
