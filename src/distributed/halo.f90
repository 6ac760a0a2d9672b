!> Halo of a rank: unknowns of other ranks beside its own ones, and the messages that bring and return their values.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! The unknowns of a matrix are divided among the ranks. A rank lists its own unknowns, ascending, and then the halo: those of
!! other ranks that an entry of the matrix joins to its own, rank by rank and ascending. A neighbour lists the same unknowns in the
!! same order for its messages, because the pattern is symmetric. Values of neighbours are added in the order of the ranks: the
!! result has the same bits in every run.
!!
!! If each rank has a part of the matrix (that of its own elements), no rank knows alone what lies around its unknowns: the ranks
!! gather the lists of the unknowns in all halos, and nothing else.
module amontons_halo
  use amontons_kinds, only: DP, I64
  use amontons_containers, only: list_groups, sort_integers
  use amontons_sparse, only: sparse_type
  use amontons_mpi_ranks, only: n_ranks, exchange_with_ranks, join_parts
  implicit none
  private
  public :: halo_type, halo_list_type, find_halo, list_halos, find_halo_in_lists, list_domain, fill_halo, return_halo

  integer, parameter :: BYTES_OF_NUMBER = storage_size(1.0_DP) / 8

  !> The unknowns of a rank and its messages. Vectors hold the own unknowns, then the halo.
  type :: halo_type
    integer :: n_own = 0
    integer, allocatable :: unknown(:)             !< (n) own unknowns, then those of the halo
    integer, allocatable :: neighbour(:)           !< (m) ranks, from 0, ascending
    integer, allocatable :: first(:)               !< (m + 1) first place of each neighbour's unknowns in the halo, from 1
    integer, allocatable :: send_first(:)          !< (m + 1) first place of a neighbour in `send`
    integer, allocatable :: send(:)                !< own unknowns in the halos of the neighbours, as places in `unknown`
    real(DP), allocatable :: n_holders(:)          !< (n_own) ranks that hold the unknown: this one, and those in whose halo it is
    integer(I64) :: n_messages = 0                 !< sent so far
    integer(I64) :: n_bytes = 0                    !< in them
  end type halo_type

  !> The unknowns in the halos of all ranks.
  type :: halo_list_type
    integer, allocatable :: first(:)               !< (n_ranks + 1) first place of each rank's halo
    integer, allocatable :: unknown(:)             !< in the order of `halo_type`
  end type halo_list_type

contains

  !> Lists own unknowns, halo and messages of a rank. Cost: linear in the entries.
  subroutine find_halo(self, pattern, owner, rank)
    type(halo_type), intent(out) :: self
    type(sparse_type), intent(in) :: pattern       !< upper triangle
    integer, intent(in) :: owner(:)                !< (n) rank of each unknown, from 0
    integer, intent(in) :: rank                    !< this one
    integer, allocatable :: inside(:), outside(:)  ! own unknown and other unknown of each entry between ranks
    integer, allocatable :: others(:), place(:)
    integer :: i, k
    call list_border(pattern, owner, rank, inside, outside)
    self%unknown = pack([(i, i=1, size(owner))], owner == rank)
    self%n_own = size(self%unknown)
    allocate (place(size(owner)), source=0)
    place(self%unknown) = [(i, i=1, self%n_own)]
    others = owner(outside)
    call keep_distinct(others)
    self%neighbour = others
    allocate (self%first(size(others) + 1), self%send_first(size(others) + 1), source=1)
    self%send = [integer ::]
    do k = 1, size(others)
      call append_distinct(pack(outside, owner(outside) == others(k)), self%unknown)
      self%first(k + 1) = size(self%unknown) - self%n_own + 1
      call append_distinct(place(pack(inside, owner(outside) == others(k))), self%send)
      self%send_first(k + 1) = size(self%send) + 1
    end do
    call count_holders(self)
  end subroutine find_halo


  !> The halos of all ranks, by the parts of a matrix on each; all ranks call it.
  subroutine list_halos(self, part, owner)
    type(halo_list_type), intent(out) :: self
    type(sparse_type), intent(in) :: part          !< of the matrix: upper triangle
    integer, intent(in) :: owner(:)                !< (n) rank of each unknown, from 0
    integer, allocatable :: found(:), of_rank(:), of_entry(:), inside(:), outside(:)
    real(DP), allocatable :: unknowns(:), ranks(:)
    integer :: r
    call list_crossings(part, owner, of_entry, inside, outside)
    found = [integer ::]
    of_rank = [integer ::]
    do r = 0, n_ranks() - 1
      call append_distinct(pack(outside, of_entry == r), found)
      of_rank = [of_rank, spread(r, 1, size(found) - size(of_rank))]
    end do
    call join_parts(real(found, DP), unknowns)
    call join_parts(real(of_rank, DP), ranks)
    found = nint(unknowns)
    of_rank = nint(ranks)
    allocate (self%first(n_ranks() + 1), source=1)
    self%unknown = [integer ::]
    do r = 0, n_ranks() - 1
      call append_by_owner(pack(found, of_rank == r), owner, self%unknown)
      self%first(r + 2) = size(self%unknown) + 1
    end do
  end subroutine list_halos


  !> Appends distinct unknowns, rank by rank of their owners and ascending.
  subroutine append_by_owner(items, owner, list)
    integer, intent(in) :: items(:), owner(:)
    integer, allocatable, intent(inout) :: list(:)
    integer, allocatable :: distinct(:), first(:), members(:)
    distinct = items
    call keep_distinct(distinct)
    call list_groups(owner(distinct) + 1, n_ranks(), first, members)
    list = [list, distinct(members)]
  end subroutine append_by_owner


  !> The unknowns of a rank, then those of its halo.
  pure function list_domain(halos, owner, rank) result(unknown)
    type(halo_list_type), intent(in) :: halos
    integer, intent(in) :: owner(:), rank
    integer, allocatable :: unknown(:)
    integer :: i
    unknown = [pack([(i, i=1, size(owner))], owner == rank), halos%unknown(halos%first(rank + 1):halos%first(rank + 2) - 1)]
  end function list_domain


  !> The halo of a rank from those of all.
  subroutine find_halo_in_lists(self, halos, owner, rank)
    type(halo_type), intent(out) :: self
    type(halo_list_type), intent(in) :: halos
    integer, intent(in) :: owner(:)                !< (n) rank of each unknown, from 0
    integer, intent(in) :: rank                    !< this one
    integer, allocatable :: others(:), place(:)
    integer :: i, k
    self%unknown = list_domain(halos, owner, rank)
    self%n_own = count(owner == rank)
    allocate (place(size(owner)), source=0)
    place(self%unknown(:self%n_own)) = [(i, i=1, self%n_own)]
    others = owner(self%unknown(self%n_own + 1:))
    call keep_distinct(others)
    self%neighbour = others
    allocate (self%first(size(others) + 1), self%send_first(size(others) + 1), source=1)
    self%send = [integer ::]
    do k = 1, size(others)
      self%first(k + 1) = self%first(k) + count(owner(self%unknown(self%n_own + 1:)) == others(k))
      associate (theirs => halos%unknown(halos%first(others(k) + 1):halos%first(others(k) + 2) - 1))
        self%send = [self%send, place(pack(theirs, owner(theirs) == rank))]
      end associate
      self%send_first(k + 1) = size(self%send) + 1
    end do
    call count_holders(self)
  end subroutine find_halo_in_lists


  !> The ranks that hold each own unknown.
  pure subroutine count_holders(self)
    type(halo_type), intent(inout) :: self
    integer :: k
    allocate (self%n_holders(self%n_own), source=1.0_DP)
    do k = 1, size(self%send)
      self%n_holders(self%send(k)) = self%n_holders(self%send(k)) + 1
    end do
  end subroutine count_holders


  !> The entries that join an unknown of a rank to one of another rank.
  subroutine list_border(pattern, owner, rank, inside, outside)
    type(sparse_type), intent(in) :: pattern
    integer, intent(in) :: owner(:), rank
    integer, allocatable, intent(out) :: inside(:)   !< unknown of the rank
    integer, allocatable, intent(out) :: outside(:)  !< the other one
    integer, allocatable :: of_rank(:)
    call list_crossings(pattern, owner, of_rank, inside, outside)
    inside = pack(inside, of_rank == rank)
    outside = pack(outside, of_rank == rank)
  end subroutine list_border


  !> The entries that join unknowns of two ranks, each twice: once for each of both.
  pure subroutine list_crossings(pattern, owner, of_rank, inside, outside)
    type(sparse_type), intent(in) :: pattern
    integer, intent(in) :: owner(:)
    integer, allocatable, intent(out) :: of_rank(:), inside(:), outside(:)   !< rank, its own unknown, that of the other
    integer :: pass, n, i, p
    do pass = 1, 2
      n = 0
      do i = 1, pattern%n_rows
        do p = pattern%first(i), pattern%first(i + 1) - 1
          associate (j => pattern%column(p))
            if (owner(i) == owner(j)) cycle
            n = n + 2
            if (pass == 1) cycle
            of_rank(n - 1:n) = [owner(i), owner(j)]
            inside(n - 1:n) = [i, j]
            outside(n - 1:n) = [j, i]
          end associate
        end do
      end do
      if (pass == 1) allocate (of_rank(n), inside(n), outside(n))
    end do
  end subroutine list_crossings


  !> Sorts a list and drops repeated items.
  subroutine keep_distinct(list)
    integer, allocatable, intent(inout) :: list(:)
    integer :: k
    call sort_integers(list)
    list = [list(:min(1, size(list))), pack(list(2:), [(list(k) /= list(k - 1), k=2, size(list))])]
  end subroutine keep_distinct


  !> Appends the distinct items of a list, ascending.
  subroutine append_distinct(items, list)
    integer, intent(in) :: items(:)
    integer, allocatable, intent(inout) :: list(:)
    integer, allocatable :: distinct(:)
    distinct = items
    call keep_distinct(distinct)
    list = [list, distinct]
  end subroutine append_distinct


  !> Fills the halo of a vector with the values of its owners.
  subroutine fill_halo(self, x)
    type(halo_type), intent(inout) :: self
    real(DP), intent(inout) :: x(:)                !< (n) in: own values
    call exchange_with_ranks(self%neighbour, self%send_first, x(self%send), self%first, x(self%n_own + 1:))
    call count_messages(self, size(self%send))
  end subroutine fill_halo


  !> Returns the values in the halo to the owners, who add them.
  subroutine return_halo(self, x)
    type(halo_type), intent(inout) :: self
    real(DP), intent(inout) :: x(:)                !< (n) in: a contribution to all unknowns; out: own sums
    real(DP) :: returned(size(self%send))
    integer :: k
    call exchange_with_ranks(self%neighbour, self%first, x(self%n_own + 1:), self%send_first, returned)
    call count_messages(self, size(x) - self%n_own)
    do k = 1, size(self%send)
      x(self%send(k)) = x(self%send(k)) + returned(k)
    end do
  end subroutine return_halo


  !> Counts a message to each neighbour.
  subroutine count_messages(self, n_numbers)
    type(halo_type), intent(inout) :: self
    integer, intent(in) :: n_numbers               !< in all of them
    self%n_messages = self%n_messages + size(self%neighbour, kind=I64)
    self%n_bytes = self%n_bytes + BYTES_OF_NUMBER * int(n_numbers, I64)
  end subroutine count_messages

end module amontons_halo
