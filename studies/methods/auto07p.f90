! Equations for AUTO-07p: a loop of revolute joints, the circle, the pitchfork, Bratu's problem, and those of another
! file (kind 5), which has the subroutine `other_equations`.
!
! `auto07p.py` compiles this file once and writes problem.dat for each run: the kind, the numbers of equations and of
! unknowns, which unknown is AUTO's parameter, how many mixtures of the equations are solved, the arclength to follow,
! the start, the mixtures by rows, and for a loop what `LoopClosure` hands to its kernels. Every point goes to
! points.bin in full precision: AUTO's own files are kept short. The last record is the processor time in s.

module problem
  implicit none
  integer, parameter :: loop = 1, circle = 2, pitchfork = 3, bratu = 4, other = 5
  integer :: kind, equations, unknowns, parameter_at, mixtures, points_unit
  double precision :: length, travelled, began
  double precision, allocatable :: start(:), last(:), mix(:, :), geometry(:, :)
  integer, allocatable :: others(:)

contains

  subroutine read_problem
    integer :: unit, k
    call cpu_time(began)
    open (newunit=unit, file='problem.dat', status='old', action='read')
    read (unit, *) kind, equations, unknowns, parameter_at, mixtures, length
    allocate (start(unknowns), last(unknowns), mix(mixtures, equations), geometry(unknowns, 6))
    read (unit, *) start
    do k = 1, mixtures
      read (unit, *) mix(k, :)
    end do
    if (kind == loop) read (unit, *) geometry
    close (unit)
    others = pack([(k, k=1, unknowns)], [(k /= parameter_at, k=1, unknowns)])
    open (newunit=points_unit, file='points.bin', access='stream', form='unformatted', status='replace')
    write (points_unit) start
    last = start
    travelled = 0
  end subroutine

  ! The point of AUTO's unknowns and parameter.
  function joined(u, p) result(x)
    double precision, intent(in) :: u(:), p
    double precision :: x(unknowns)
    x(others) = u
    x(parameter_at) = p
  end function

  ! Writes a point down; after the whole length, the time too, and ends the program.
  subroutine record(x)
    double precision, intent(in) :: x(:)
    double precision :: now, moved
    moved = norm2(x - last)
    if (moved == 0) return  ! AUTO shows most points twice
    write (points_unit) x
    last = x
    travelled = travelled + moved
    if (travelled < length) return
    call cpu_time(now)
    write (points_unit) now - began
    close (points_unit)
    stop
  end subroutine

  ! F (equations) and F' (equations, unknowns) at x.
  subroutine evaluate(x, f, jacobian)
    double precision, intent(in) :: x(unknowns)
    double precision, intent(out) :: f(equations), jacobian(equations, unknowns)
    external :: other_equations
    double precision :: h2
    integer :: i
    select case (kind)
    case (loop)
      call close_loop(x, f, jacobian)
    case (circle)
      f(1) = x(1)**2 + x(2)**2 - 1
      jacobian(1, :) = 2*x
    case (pitchfork)
      f(1) = x(1)**3 - x(2)*x(1)
      jacobian(1, :) = [3*x(1)**2 - x(2), -x(1)]
    case (bratu)
      h2 = 1/dble(unknowns)**2
      jacobian = 0
      jacobian(:, unknowns) = h2*exp(x(:equations))
      f = x(unknowns)*jacobian(:, unknowns) - 2*x(:equations)
      f(2:) = f(2:) + x(:equations - 1)
      f(:equations - 1) = f(:equations - 1) + x(2:equations)
      do i = 1, equations
        jacobian(i, i) = x(unknowns)*jacobian(i, unknowns) - 2
        if (i > 1) jacobian(i, i - 1) = 1
        if (i < equations) jacobian(i, i + 1) = 1
      end do
    case (other)
      call other_equations(x, f, jacobian)
    end select
  end subroutine

  ! Closure of a loop as in `linkages.kernels`: twice the vector part of the quaternion, and the translation.
  subroutine close_loop(theta, f, jacobian)
    double precision, intent(in) :: theta(unknowns)
    double precision, intent(out) :: f(6), jacobian(6, unknowns)
    double precision :: rotation(3, 3), q(4), x(3), z(3), p(3), c, s
    integer :: i
    rotation = reshape([1d0, 0d0, 0d0, 0d0, 1d0, 0d0, 0d0, 0d0, 1d0], [3, 3])
    q = [1d0, 0d0, 0d0, 0d0]
    p = 0
    do i = 1, unknowns  ! geometry(i, :) is a, d, cos and sin of the twist, cos and sin of half of it
      jacobian(1:3, i) = rotation(:, 3)
      jacobian(4:6, i) = cross(p, rotation(:, 3))
      c = cos(theta(i)/2)
      s = sin(theta(i)/2)
      q = [q(1)*c - q(4)*s, q(2)*c + q(3)*s, q(3)*c - q(2)*s, q(4)*c + q(1)*s]
      q = [q(1)*geometry(i, 5) - q(2)*geometry(i, 6), q(2)*geometry(i, 5) + q(1)*geometry(i, 6), &
           q(3)*geometry(i, 5) + q(4)*geometry(i, 6), q(4)*geometry(i, 5) - q(3)*geometry(i, 6)]
      x = (c*c - s*s)*rotation(:, 1) + 2*s*c*rotation(:, 2)
      z = (c*c - s*s)*rotation(:, 2) - 2*s*c*rotation(:, 1)  ! the y axis after the joint
      p = p + geometry(i, 1)*x + geometry(i, 2)*rotation(:, 3)
      rotation(:, 2) = geometry(i, 3)*z + geometry(i, 4)*rotation(:, 3)
      rotation(:, 3) = geometry(i, 3)*rotation(:, 3) - geometry(i, 4)*z
      rotation(:, 1) = x
    end do
    f(1:3) = 2*q(2:4)
    f(4:6) = p
    do i = 1, unknowns
      jacobian(4:6, i) = jacobian(4:6, i) + cross(jacobian(1:3, i), p)
      jacobian(1:3, i) = q(1)*jacobian(1:3, i) + cross(jacobian(1:3, i), q(2:4))
    end do
  end subroutine

  pure function cross(a, b)
    double precision, intent(in) :: a(3), b(3)
    double precision :: cross(3)
    cross = [a(2)*b(3) - a(3)*b(2), a(3)*b(1) - a(1)*b(3), a(1)*b(2) - a(2)*b(1)]
  end function
end module

subroutine func(ndim, u, icp, par, ijac, f, dfdu, dfdp)
  use problem
  implicit none
  integer, intent(in) :: ndim, icp(*), ijac
  double precision, intent(in) :: u(ndim), par(*)
  double precision, intent(out) :: f(ndim)
  double precision, intent(inout) :: dfdu(ndim, ndim), dfdp(ndim, *)
  double precision :: value(equations), jacobian(equations, unknowns)
  call evaluate(joined(u, par(1)), value, jacobian)
  if (mixtures == 0) then
    f = value
    if (ijac == 0) return
    dfdu = jacobian(:, others)
    dfdp(:, 1) = jacobian(:, parameter_at)
  else
    f = matmul(mix, value)
    if (ijac == 0) return
    dfdu = matmul(mix, jacobian(:, others))
    dfdp(:, 1) = matmul(mix, jacobian(:, parameter_at))
  end if
end subroutine

subroutine stpnt(ndim, u, par, t)
  use problem
  implicit none
  integer, intent(in) :: ndim
  double precision, intent(inout) :: u(ndim), par(*)
  double precision, intent(in) :: t
  call read_problem
  u = start(others)
  par(1) = start(parameter_at)
end subroutine

subroutine pvls(ndim, u, par)
  use problem
  implicit none
  integer, intent(in) :: ndim
  double precision, intent(in) :: u(ndim)
  double precision, intent(inout) :: par(*)
  call record(joined(u, par(1)))
end subroutine

subroutine bcnd
end subroutine

subroutine icnd
end subroutine

subroutine fopt
end subroutine
